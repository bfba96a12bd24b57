"""Pictures without noise, to look at: never measured, and nothing that is measured knows them."""
