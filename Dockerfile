# syntax=docker/dockerfile:1
# One image with the server (dashboard inside) and the agent; small, non-root.
#   docker build -t binnacle .
#   docker run -p 8080:8080 -v binnacle:/var/lib/binnacle binnacle
# The agent, with data_dir = "/var/lib/binnacle" in agent.toml; run `enrol` first, likewise:
#   docker run -v agent:/var/lib/binnacle -v ./agent.toml:/etc/binnacle/agent.toml:ro binnacle \
#     binnacle-agent run --config /etc/binnacle/agent.toml

FROM node:24-bookworm-slim AS web
WORKDIR /src/web
COPY web/package.json web/package-lock.json web/.npmrc ./
RUN npm ci --no-audit --no-fund
COPY server/openapi.json ../server/openapi.json
# The help is made from them.
COPY docs/ ../docs/
COPY CHANGELOG.md ../CHANGELOG.md
COPY web/ ./
RUN npm run build

# The version in rust-toolchain.toml.
FROM rust:1.95.0-bookworm AS build
WORKDIR /src
COPY Cargo.toml Cargo.lock clippy.toml ./
COPY crates/ crates/
COPY server/ server/
COPY agent/ agent/
COPY migrations/ migrations/
COPY tests/ tests/
COPY --from=web /src/web/dist web/dist
RUN --mount=type=cache,target=/usr/local/cargo/registry \
    --mount=type=cache,target=/src/target \
    cargo build --release --locked -p binnacle-server -p binnacle-agent \
    && install -D -t /out target/release/binnacle-server target/release/binnacle-agent

FROM gcr.io/distroless/cc-debian12:nonroot
COPY --from=build --chown=nonroot:nonroot /out/ /usr/local/bin/
WORKDIR /var/lib/binnacle
VOLUME /var/lib/binnacle
ENV BINNACLE_DATABASE_URL=sqlite:///var/lib/binnacle/binnacle.db \
    BINNACLE_LISTEN=0.0.0.0:8080
EXPOSE 8080
CMD ["/usr/local/bin/binnacle-server", "serve"]
