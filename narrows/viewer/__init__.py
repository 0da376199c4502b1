"""What people look at. Nothing here is imported before it is drawn."""
