"""Readers of drawings and files of geometry."""
