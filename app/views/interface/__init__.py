"""Views of interfaces: pressure, friction, and where they slip."""
