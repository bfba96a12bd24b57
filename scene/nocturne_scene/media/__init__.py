"""Published fog, milk, air, skin and smoke: presets, Mie and Rayleigh scattering, density grids."""
