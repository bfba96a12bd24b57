-- Why a render will not reach the error that it asks for before a time ends it; empty: it will, or nobody knows.
ALTER TABLE render ADD COLUMN out_of_reach TEXT NOT NULL DEFAULT '';
-- Whether webhooks were told: once for each render and its conditions.
ALTER TABLE render ADD COLUMN out_of_reach_told INTEGER NOT NULL DEFAULT 0;

-- What a message is of, where it is no end.
ALTER TABLE webhook_message ADD COLUMN event TEXT NOT NULL DEFAULT '';
CREATE TRIGGER webhook_of_render_out_of_reach AFTER UPDATE OF out_of_reach ON render
WHEN NEW.out_of_reach <> '' AND NEW.out_of_reach_told = 0
BEGIN
    INSERT INTO webhook_message
        (webhook_id, message_id, render_id, name, state, reason, doubt, event, unix_time, due)
    SELECT id, 'msg_' || lower(hex(randomblob(16))), NEW.id, NEW.name, NEW.state, NEW.out_of_reach, NEW.doubt,
        'out_of_reach', unixepoch(), 0
    FROM webhook WHERE owner = NEW.owner;
    UPDATE render SET out_of_reach_told = 1 WHERE id = NEW.id;
END;
