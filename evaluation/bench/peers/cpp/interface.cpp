// SPDX-License-Identifier: MIT OR Apache-2.0
// The C interface that lib.rs passes on.
#include <cstdio>
#include <exception>

#include "peer.hpp"

using namespace bench;

extern "C" Peer* bench_peer_new(const char* method, uint32_t threads, const BodyView* bodies, size_t count) {
  try {
    const Bodies views(bodies, bodies + count);
    if (auto peer = make_lower_bound(method, views)) return peer.release();
    if (auto peer = make_embree(method, threads, views)) return peer.release();
    if (auto peer = make_fcl(method, views)) return peer.release();
    if (auto peer = make_bullet(method, views)) return peer.release();
    if (auto peer = make_rust(method, threads, views)) return peer.release();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", method, error.what());
  }
  return nullptr;
}

extern "C" bool bench_peer_step(Peer* peer, Stages* stages) { return peer->step(*stages); }

extern "C" const Contact* bench_peer_contacts(const Peer* peer, size_t* count) {
  *count = peer->contacts.size();
  return peer->contacts.data();
}

extern "C" void bench_peer_free(Peer* peer) { delete peer; }
