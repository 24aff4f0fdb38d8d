"""The compiled inside of the buffer: columns, grid, storing, looking up."""
