"""Published spectra, indices of refraction, spectral lines, and colours as spectra."""
