-- How a render is traced and why, where a pilot chose.
ALTER TABLE render ADD COLUMN way TEXT NOT NULL DEFAULT '';
