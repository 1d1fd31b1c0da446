"""What all views draw with: curves, axes, colours, legends, strokes, units, figures."""
