"""Pictures: cameras, the rasterizer, the ray renderer and OpenGL."""
