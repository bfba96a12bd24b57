-- Columns are called what the API calls them.
DROP TRIGGER webhook_of_render_out_of_reach;
ALTER TABLE render RENAME COLUMN doubt TO error_warning;
ALTER TABLE render RENAME COLUMN out_of_reach TO target_unreachable;
ALTER TABLE render RENAME COLUMN out_of_reach_told TO unreachable_reported;
ALTER TABLE render RENAME COLUMN unseen_pixels TO zero_pixels;
ALTER TABLE render RENAME COLUMN worst_share TO top_percent_share;
ALTER TABLE error_point RENAME COLUMN worst_share TO top_percent_share;
ALTER TABLE webhook_message RENAME COLUMN doubt TO error_warning;
UPDATE webhook_message SET event = 'target_unreachable' WHERE event = 'out_of_reach';
CREATE TRIGGER webhook_of_unreachable_target AFTER UPDATE OF target_unreachable ON render
WHEN NEW.target_unreachable <> '' AND NEW.unreachable_reported = 0
BEGIN
    INSERT INTO webhook_message
        (webhook_id, message_id, render_id, name, state, reason, error_warning, event, unix_time, due)
    SELECT id, 'msg_' || lower(hex(randomblob(16))), NEW.id, NEW.name, NEW.state, NEW.target_unreachable,
        NEW.error_warning, 'target_unreachable', unixepoch(), 0
    FROM webhook WHERE owner = NEW.owner;
    UPDATE render SET unreachable_reported = 1 WHERE id = NEW.id;
END;
