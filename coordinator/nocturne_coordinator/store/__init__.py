"""What the data folder is made of: its database, the rows read from it, and who may change them."""
