-- What was ever done, by name: it never falls, whatever is deleted or thrown away.
CREATE TABLE counted (
    name TEXT PRIMARY KEY,
    value REAL NOT NULL
) STRICT;
INSERT INTO counted SELECT 'samples', total(photons * 1.0 / photons_per_sample) FROM render;
INSERT INTO counted SELECT 'rays', total(rays) FROM render;
INSERT INTO counted SELECT 'cpu_seconds',
    total(cpu_seconds) + (SELECT total(cpu_seconds) FROM deleted_usage) FROM render;
INSERT INTO counted SELECT 'ended_' || state, count(*) FROM render
    WHERE state NOT IN ('QUEUED', 'RUNNING', 'PAUSED') GROUP BY state;
CREATE TRIGGER work_is_counted AFTER UPDATE OF photons, rays, cpu_seconds ON render
WHEN NEW.photons > OLD.photons OR NEW.rays > OLD.rays OR NEW.cpu_seconds > OLD.cpu_seconds
BEGIN
    UPDATE counted SET value = value + max(0, NEW.photons - OLD.photons) * 1.0 / NEW.photons_per_sample
        WHERE name = 'samples';
    UPDATE counted SET value = value + max(0, NEW.rays - OLD.rays) WHERE name = 'rays';
    UPDATE counted SET value = value + max(0, NEW.cpu_seconds - OLD.cpu_seconds) WHERE name = 'cpu_seconds';
END;
CREATE TRIGGER end_is_counted AFTER UPDATE OF state ON render
WHEN NEW.state <> OLD.state AND NEW.state NOT IN ('QUEUED', 'RUNNING', 'PAUSED')
BEGIN
    INSERT INTO counted VALUES ('ended_' || NEW.state, 1)
    ON CONFLICT (name) DO UPDATE SET value = value + 1;
END;
