"""Every name in Redis; docs/queue.md says who reads and writes each."""

PREFIX = "nocturne:"

JOBS = PREFIX + "jobs"
"""Stream; each entry has one field JOB_FIELD, a serialised Job."""

RESULTS = PREFIX + "results"
"""Stream; each entry has one field RESULT_FIELD, a serialised JobResult."""

WORKERS_GROUP = "workers"
"""Consumer group of JOBS; a consumer is `<worker id>/<thread>`."""

SESSION = PREFIX + "session"
"""String: the token of the coordinator's run. Missing or other: Redis lost what was in it."""

WORKER_PREFIX = PREFIX + "worker:"
"""Strings `nocturne:worker:<worker id>`, a serialised WorkerStatus, with a time to live of 10 s."""

JOB_FIELD = b"job"
RESULT_FIELD = b"result"
