"""Bodies in the plane: any shape here, makers of these, rectangles; laws of joints."""
