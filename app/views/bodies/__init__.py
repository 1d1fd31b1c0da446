"""Views of bodies: how they lie, what holds them, what acts on them, stress in them."""
