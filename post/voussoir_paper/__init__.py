"""The paper, section 3: its decks, tables, figures, and the report that compares them."""
