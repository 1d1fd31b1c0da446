"""Bodies of any shape made from few data: bands, arches, bundles, named meshes."""
