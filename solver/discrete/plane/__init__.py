"""Bodies in the plane: data, meshes, condensation, cuts, joints."""
