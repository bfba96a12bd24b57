"""Spectra: what is published, and tables of wavelength for the tracer."""
