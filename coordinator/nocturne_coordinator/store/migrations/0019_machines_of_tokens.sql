-- Several machines may enrol with one token, each by the name of its node.
ALTER TABLE machine ADD COLUMN token TEXT NOT NULL DEFAULT '';
UPDATE machine SET token = name;
