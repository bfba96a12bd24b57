-- What a render's scene can hardly mean, sentences with their places, as JSON: told when it is compiled.
ALTER TABLE render ADD COLUMN warnings TEXT NOT NULL DEFAULT '[]';
