# SPDX-License-Identifier: Apache-2.0
# An image with tactus, built and tested by the two commands of the README:
#   docker build --tag tactus .
#   docker run --rm tactus run experiments/tapping.toml
FROM debian:12
RUN apt-get update && apt-get install --yes --no-install-recommends ca-certificates git make
COPY . /tactus
WORKDIR /tactus
RUN make run
RUN make test
ENV PATH="/tactus/build/release/bin:$PATH"
ENTRYPOINT ["tactus"]
