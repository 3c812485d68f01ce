// SPDX-License-Identifier: MIT
#include "packer.hpp"

#include <algorithm>

#include "g4lidar/recording/writer.hpp"

#ifdef G4LIDAR_ZSTD
#include <zstd.h>
#endif

namespace g4lidar {

#ifdef G4LIDAR_ZSTD

bool has_zstd() noexcept { return true; }

namespace mcap {
namespace {

/// The raw bytes of a lidar are mostly noise: higher levels cost time and save almost nothing.
constexpr int level = 1;
/// A larger window is not needed for chunks of 64 MiB.
constexpr int largest_window_log = 26;
constexpr std::size_t piece = std::size_t{256} << 10U;

}  // namespace

packer::packer(std::size_t usual_size)
    : context_(ZSTD_createCCtx(), [](void* of) { ZSTD_freeCCtx(static_cast<ZSTD_CCtx*>(of)); }),
      packed_(ZSTD_compressBound(usual_size)) {}

bytes packer::pack(bytes data) {
  auto* const context = static_cast<ZSTD_CCtx*>(context_.get());
  if (context == nullptr) return {};
  packed_.resize(std::max(packed_.size(), ZSTD_compressBound(data.size())));
  const std::size_t size =
      ZSTD_compressCCtx(context, packed_.data(), packed_.size(), data.data(), data.size(), level);
  return ZSTD_isError(size) != 0 ? bytes() : bytes(packed_).first(size);
}

unpacker::unpacker()
    : context_(ZSTD_createDCtx(), [](void* of) { ZSTD_freeDCtx(static_cast<ZSTD_DCtx*>(of)); }) {}

bool unpacker::unpack(bytes packed, std::size_t size, std::vector<std::uint8_t>& out,
                      const std::function<bool(bytes)>& take) {
  auto* const context = static_cast<ZSTD_DCtx*>(context_.get());
  if (context == nullptr) return false;
  ZSTD_DCtx_reset(context, ZSTD_reset_session_and_parameters);
  ZSTD_DCtx_setParameter(context, ZSTD_d_windowLogMax, largest_window_log);
  ZSTD_inBuffer from{packed.data(), packed.size(), 0};
  if (out.size() < std::min(size, piece)) out.resize(std::min(size, piece));
  std::size_t done = 0;
  std::size_t left = 1;
  while (left > 0 || from.pos < from.size) {  // there may be several frames
    ZSTD_outBuffer to{out.data(), std::min({size, out.size(), done + piece}), done};
    const std::size_t taken = from.pos;
    left = ZSTD_decompressStream(context, &to, &from);
    if (ZSTD_isError(left) != 0) return false;
    const bool is_stuck = to.pos == done && from.pos == taken;
    done = to.pos;
    if (!take(bytes(out).first(done))) return false;
    if (done == out.size() && done < size) {
      out.resize(std::min(size, 2 * out.size()));
    } else if (is_stuck) {
      return false;
    }
  }
  return done == size;
}

}  // namespace mcap

#else

bool has_zstd() noexcept { return false; }

namespace mcap {

packer::packer(std::size_t) : context_(nullptr, [](void*) {}) {}
bytes packer::pack(bytes) { return {}; }
unpacker::unpacker() : context_(nullptr, [](void*) {}) {}
bool unpacker::unpack(bytes, std::size_t, std::vector<std::uint8_t>&,
                      const std::function<bool(bytes)>&) {
  return false;
}

}  // namespace mcap

#endif

}  // namespace g4lidar
