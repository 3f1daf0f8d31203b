"""The command `voussoir`: one subcommand a module."""
