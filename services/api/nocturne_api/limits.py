"""What callers can ask of the API process, with reasons. Renders have the coordinator's bounds."""

from nocturne_scene.limits import MAX_SCENE_BYTES

MEBIBYTE = 1024 * 1024

# A create request in REST: mostly the scene document, so the same bound.
CREATE_BODY_BYTES = MAX_SCENE_BYTES
# gRPC holds a message in memory before any of our code sees it, so its limit is close to the document's.
GRPC_MESSAGE_BYTES = 9 * MEBIBYTE

# Digests in one question about missing assets: 10,000 of them are 700 KB of JSON.
DIGESTS_PER_REQUEST = 10_000
SMALL_BODY_BYTES = MEBIBYTE

# Compiling is processor work in a thread; two at once, and a short queue whose documents fit in memory.
COMPILES_AT_ONCE = 2
# Beyond those, one of each of so many owners who have none: some scenes take minutes.
COMPILES_OF_NEWCOMERS = 4
COMPILES_WAITING = 16
# Of those, one owner's: the others' places are for others.
COMPILES_WAITING_OF_OWNER = 8

# Renders of one group request, and bytes of all their documents together: those are in memory until all are
# compiled.
GROUP_RENDERS = 10_000
GROUP_BYTES = 512 * MEBIBYTE

# A preflight renders small images on this machine: one at a time, with so much processor time at most,
# seconds.
PREFLIGHT_BUDGET_S = 120.0
# Beside its renders a preflight compiles, and the machine does other things: then it is ended.
PREFLIGHT_WALL_S = 900.0

# Scenes of other renderers are imported in child processes: those of the corpus take up to 13 s and 1 GB.
IMPORTS_AT_ONCE = 2
IMPORT_FILES = 10_000
IMPORT_BYTES = 4096 * MEBIBYTE
IMPORT_MEMORY_BYTES = 8192 * MEBIBYTE
IMPORT_CPU_S = 300
IMPORT_WALL_S = 600.0
IMPORT_KEPT_S = 86_400.0

# Pictures that the page brings to compare with: each in a child process, of a film's size at most.
PICTURE_BYTES = 512 * MEBIBYTE
PICTURE_PIXELS = 2**24
# Seven channels in double precision are 0.9 GiB, and OpenImageIO's own copies; shared libraries count, too.
PICTURE_MEMORY_BYTES = 4096 * MEBIBYTE
PICTURE_WALL_S = 60.0
PICTURES_AT_ONCE = 2
PICTURES_WAITING = 8
# Pictures that are being received, each a file; of one owner, with authentication; and how long one may take.
PICTURES_COMING = 16
PICTURES_OF_OWNER = 2
PICTURE_COMES_S = 600.0

DENOISE_WALL_S = 300.0
# Callers that wait for a denoised image, and for the image of a render that goes on.
DENOISES_WAITING = 8
IMAGES_WAITING = 8

# Measurements read an image's sums, row by row: seconds of a processor for a film of 4K.
MEASUREMENTS_AT_ONCE = 2

# Calls of one caller, with authentication: the page makes a few a second, a farm's scripts some more.
CALLS_PER_SECOND = 100.0
CALLS_AT_ONCE = 1000.0

# What one owner may have, with authentication; each can be set. As many renders as a list of all still takes
# less than a second for.
OWNER_OPEN_RENDERS = 10_000
# Samples of pixels that an owner's open renders ask for: a farm of 10,000 cores traces them in some two days.
OWNER_OPEN_SAMPLES = 1e15
# Uploads and finished renders: a few hundred of the largest films, or a disk of the usual size half full.
OWNER_STORED_BYTES = 256 * 1024 * MEBIBYTE

# Files that no render uses stay for a week: uploads go before the render that names them, and people go home.
UNUSED_SECONDS = 7 * 86400.0
# How often the data folder is measured, seconds; at this part of its bound, or of its disk, the log warns.
MEASURE_S = 30.0
NEARLY_FULL = 0.9

# Uploads in progress, each with a thread and an open file; and one owner's, with authentication.
UPLOADS_AT_ONCE = 128
UPLOADS_OF_OWNER = 32

# Threads that read the database at once. How long a call waits for one of them, or for its turn to
# write, and then for another process that writes, seconds: callers hear within both together that it is slow.
READERS = 4
DATABASE_TURN_S = 5.0
DATABASE_LOCK_S = 3.0
# How long /readyz waits for each thing, how long its answer holds, and how long coordinators may be silent.
READY_WAIT_S = 2.0
READY_KEPT_S = 1.0
COORDINATOR_SILENT_S = 30.0

# How often the files of the certificate are looked at: those who renew do so days before the end.
CERTIFICATE_LOOK_S = 10.0

# Sessions of the page that are remembered, and how long one is good for.
SESSIONS = 10_000
SESSION_SECONDS = 7 * 86400.0

# Kept lines of the record of who changed what.
CALLS_RECORDED = 100_000
RECORDED_CHARACTERS = 128

# Each watcher holds one connection and the newest state of at most a page of renders.
WATCHERS = 256
# Of those, one owner's, with authentication.
WATCHERS_OF_OWNER = 64
# How often a change in the data folder is looked for while anybody watches, seconds: part of the wait for a
# render's first tile. And the pause after a look in times of its duration, for it notifies all watchers.
WATCH_INTERVAL_S = 0.05
WATCH_REST = 4.0

# Bytes per read when an image or a blob is sent: below gRPC's default message limit of 4 MiB.
CHUNK_BYTES = 256 * 1024
# Of one answer with tiles: a film of 512 x 512 is one call; much more would hold up a viewer.
TILES_ANSWER_BYTES = 4 * MEBIBYTE
# Answers kept for other watchers of the same render.
TILE_ANSWERS_KEPT = 8
# Renders that one stream names: one that is looked at, and those it is compared with.
RENDERS_PER_STREAM = 4

# Places at which learned light is looked up at once, each with the scene in memory, and seconds until one is
# given up.
LEARNED_AT_ONCE = 2
LEARNED_WALL_S = 60.0

# Seconds until a year of daylight is given up.
ANNUAL_WALL_S = 300.0
# And until a report is.
REPORT_WALL_S = 120.0

# What happened to workers lately, in one answer.
EVENTS_SHOWN = 100

# Uploads are written to disk in pieces of this size, to keep thread switches rare.
WRITE_BYTES = MEBIBYTE

# How long an unwanted request body is read and thrown away, so that its sender gets to read the answer.
LINGER_S = 2.0

# Problems named in one answer, and characters of each: gRPC carries them in headers of at most 8 KiB.
PROBLEMS_PER_ANSWER = 20
PROBLEM_CHARACTERS = 300

# Connections to the REST endpoint; for further ones those go on which nothing is asked, or they get 503 at
# once. Watchers hold one each, pages a few.
REST_CONNECTIONS = 2000
# Of those, one address's: half, so that nobody takes all, and a proxy in front of many is one address.
CONNECTIONS_OF_ADDRESS = 1000

# A request's head must come in this time, and its body with so many bytes a second after a while: the lower
# bounds of Apache's mod_reqtimeout, which slow links keep.
HEAD_SECONDS = 20.0
BODY_SECONDS = 20.0
BODY_BYTES_PER_SECOND = 500.0
# An answer of which nothing is read for so long is given up.
UNREAD_SECONDS = 60.0

# Wrong tokens of one address, in a burst and a second; further ones are answered late, and by 429.
WRONG_TOKENS_AT_ONCE = 10.0
WRONG_TOKENS_PER_SECOND = 1.0
WRONG_TOKEN_DELAY_S = 1.0
# Addresses of which that is remembered.
ADDRESSES_KEPT = 10_000

# Calls in progress at the gRPC endpoint, watchers included; further ones get RESOURCE_EXHAUSTED at once.
GRPC_CALLS = 1000
# Of those, one address's, as for REST; further ones get UNAVAILABLE.
GRPC_CALLS_OF_ADDRESS = 500
# On one connection: a client with more opens another one.
GRPC_CALLS_OF_CONNECTION = 200
