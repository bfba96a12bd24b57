-- Ranges that were chosen for an audit, and that no other machine was there to trace.
ALTER TABLE render ADD COLUMN unaudited INTEGER NOT NULL DEFAULT 0;
