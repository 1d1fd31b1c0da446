"""Bodies in the plane, of any shape; makers of bodies, and rectangles, in rooms."""
