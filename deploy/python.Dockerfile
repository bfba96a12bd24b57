# Images of the coordinator and of the API: targets `coordinator` and `api`. Built from the top of the repository.
FROM debian:bookworm-slim AS base
COPY deploy/debian-packages.txt deploy/debian-packages.sh /deploy/
RUN apt-get update \
 && apt-get install -y --no-install-recommends $(/deploy/debian-packages.sh python) \
 && rm -rf /var/lib/apt/lists/*
# A new volume at /data takes the owner from here.
RUN groupadd --gid 10001 nocturne \
 && useradd --uid 10001 --gid 10001 --no-create-home --home-dir /nonexistent nocturne \
 && install -d -o nocturne -g nocturne /data

# What makes the packages, and stays behind: gRPC's compiler, hatchling, Node.
FROM base AS tools
RUN apt-get update \
 && apt-get install -y --no-install-recommends $(/deploy/debian-packages.sh venv) \
 && rm -rf /var/lib/apt/lists/*
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PATH=/opt/tools/bin:$PATH
COPY requirements.lock /src/
RUN python3.11 -m venv /opt/tools && pip install --quiet --no-deps --require-hashes -r /src/requirements.lock

FROM tools AS packages
ARG SITE=/opt/nocturne/lib/python3.11/site-packages
COPY requirements-runtime.lock /src/
RUN python3.11 -m venv --without-pip /opt/nocturne \
 && pip --python /opt/nocturne/bin/python install --quiet --no-deps --require-hashes -r /src/requirements-runtime.lock
WORKDIR /src
COPY proto proto
RUN python -m grpc_tools.protoc -I proto --python_out=$SITE --grpc_python_out=$SITE proto/nocturne/v1/*.proto \
 && python -m compileall -q $SITE/nocturne
COPY pyproject.toml ./
COPY coordinator coordinator
COPY services/api services/api
COPY services/client services/client
RUN pip wheel --quiet --no-deps --no-build-isolation --wheel-dir /tmp/wheel . \
 && pip --python /opt/nocturne/bin/python install --quiet --no-deps /tmp/wheel/*.whl

FROM base AS coordinator
COPY --from=packages /opt/nocturne /opt/nocturne
# The root file system is read-only in service: a library that wants a home gets the temporary folder.
ENV PATH=/opt/nocturne/bin:$PATH PYTHONDONTWRITEBYTECODE=1 PYTHONUNBUFFERED=1 HOME=/tmp
COPY deploy/health/redis-has.sh /usr/local/bin/redis-has
USER 10001:10001
ENTRYPOINT ["nocturne-coordinator"]

FROM tools AS web
WORKDIR /src/services/web
COPY services/web/package.json services/web/package-lock.json ./
RUN npm ci --no-audit --no-fund
COPY services/web ./
RUN npm run build

FROM coordinator AS api
COPY --from=web /src/services/web/dist /opt/nocturne/web
COPY deploy/health/http-ok.sh /usr/local/bin/http-ok
ENTRYPOINT ["nocturne-api"]
