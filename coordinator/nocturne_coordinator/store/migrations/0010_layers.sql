-- Layers that were asked for, a JSON list of names, and the blob that holds them.
ALTER TABLE render ADD COLUMN layers TEXT NOT NULL DEFAULT '[]';
ALTER TABLE render ADD COLUMN layers_sha256 TEXT NOT NULL DEFAULT '';
