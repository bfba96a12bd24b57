-- What an image says of its own error: the mean of Y over pixels and its standard error, pixels that saw nothing, and why
-- the error is not to be trusted (empty: it is).
ALTER TABLE render ADD COLUMN mean REAL NOT NULL DEFAULT 0;
ALTER TABLE render ADD COLUMN mean_error REAL NOT NULL DEFAULT 0;
ALTER TABLE render ADD COLUMN unseen_pixels INTEGER NOT NULL DEFAULT 0;
ALTER TABLE render ADD COLUMN doubt TEXT NOT NULL DEFAULT '';

-- The trusted error of the tile at the range end before its last; 0: unknown. A stop by error needs two in a row.
ALTER TABLE tile ADD COLUMN error_before REAL NOT NULL DEFAULT 0;

-- Webhooks hear of the doubt, too.
ALTER TABLE webhook_message ADD COLUMN doubt TEXT NOT NULL DEFAULT '';
DROP TRIGGER webhook_of_ended_render;
CREATE TRIGGER webhook_of_ended_render AFTER UPDATE OF state ON render
WHEN NEW.state IN ('SUCCEEDED', 'STOPPED_EARLY', 'DEGRADED', 'FAILED') AND OLD.state <> NEW.state
BEGIN
    INSERT INTO webhook_message
        (webhook_id, message_id, render_id, name, state, reason, doubt, unix_time, due)
    SELECT id, 'msg_' || lower(hex(randomblob(16))), NEW.id, NEW.name, NEW.state, NEW.reason, NEW.doubt, NEW.ended, 0
    FROM webhook WHERE owner = NEW.owner;
END;

-- What Y measures; empty for renders from before this was kept.
ALTER TABLE render ADD COLUMN quantity TEXT NOT NULL DEFAULT '';
