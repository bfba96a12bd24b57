# Image of nocturne-worker, with nocturne-trace beside it. Built from the top of the repository.
# Needs a CPU of level x86-64-v3 (2013 and later): the instruction set is part of what makes images equal bit by bit.
FROM debian:bookworm-slim AS build
COPY deploy/debian-packages.txt deploy/debian-packages.sh /deploy/
RUN apt-get update \
 && apt-get install -y --no-install-recommends $(/deploy/debian-packages.sh build) \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /src/worker
COPY proto /src/proto
COPY worker /src/worker
RUN cmake --preset release -DNOCTURNE_TESTS=OFF \
 && cmake --build /src/build/release --target nocturne-worker nocturne-trace \
 && strip /src/build/release/worker/nocturne*

FROM debian:bookworm-slim AS worker
COPY deploy/debian-packages.txt deploy/debian-packages.sh /deploy/
RUN apt-get update \
 && apt-get install -y --no-install-recommends $(/deploy/debian-packages.sh worker) \
 && rm -rf /var/lib/apt/lists/*
# A new volume at /cache takes the owner from here.
RUN groupadd --gid 10001 nocturne \
 && useradd --uid 10001 --gid 10001 --no-create-home --home-dir /nonexistent nocturne \
 && install -d -o nocturne -g nocturne /cache
COPY --from=build /src/build/release/worker/ /usr/local/bin/
COPY deploy/health/redis-has.sh /usr/local/bin/redis-has
USER 10001:10001
ENTRYPOINT ["nocturne-worker"]
