"""Photometric files of lamps: IES LM-63, read and written, and EULUMDAT, read."""
