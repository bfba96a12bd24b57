"""Every name in Redis; coordinator/README.md says who reads and writes each."""

PREFIX = "nocturne:"

JOBS = PREFIX + "jobs"
"""Stream; each entry has one field JOB_FIELD, a serialised Job."""

QUICK_JOBS = PREFIX + "quick"
"""Stream of quick copies, which two further threads of each worker take; as JOBS. The coordinator calls its
entries `quick:<entry>`."""

RESULTS = PREFIX + "results"
"""Stream; each entry has one field RESULT_FIELD, a serialised JobResult."""

WORKERS_GROUP = "workers"
"""Consumer group of JOBS and of QUICK_JOBS; a consumer is `<worker id>/<thread>`."""

SESSION = PREFIX + "session"
"""String `<data folder>:<epoch>` with a time to live: the lease of a folder's coordinators on this Redis. Of
the same folder and an earlier epoch: of runs before these."""

RUN_PREFIX = PREFIX + "run:"
"""Strings `nocturne:run:<random>` with a time to live, one for each run of a coordinator. Missing: Redis lost
its contents."""

WORKER_PREFIX = PREFIX + "worker:"
"""Strings `nocturne:worker:<worker id>`, a serialised WorkerStatus, with a time to live of 10 s."""

QUARANTINE_PREFIX = PREFIX + "quarantine:"
"""Strings `nocturne:quarantine:<worker id>`, the reason, with a time to live: that worker takes no jobs."""

WITHDRAWN_PREFIX = PREFIX + "withdrawn:"
"""Strings `nocturne:withdrawn:<entry of JOBS>`, or `nocturne:withdrawn:quick:<entry of QUICK_JOBS>`, empty,
with a time to live: nobody needs that job any more, and who works on it stops."""

JOB_FIELD = b"job"
RESULT_FIELD = b"result"
LEASE_FIELD = b"lease"
"""Of a job, where workers enrol: a secret of who took it."""
MACHINE_FIELD = b"machine"
SIGNATURE_FIELD = b"signature"
"""Of a result, where workers enrol."""
