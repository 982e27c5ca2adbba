// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <bzlib.h>
#include <lz4frame.h>

#include <memory>

#include "bag_records.h"

namespace rgbd_sfm_fusion::bag {
namespace {

constexpr std::uint32_t kLargestChunk = 1U << 30U;  // recorders begin a new one after 768 kB, or one message
// A damaged number may claim much. Its memory is not touched until something comes out.
constexpr std::uint64_t kMostThatLz4Expands = 256;

std::size_t decompressLz4(const std::vector<std::uint8_t>& data, std::uint8_t* to, std::size_t size) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0)
    throw std::runtime_error("lz4: out of memory");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      made, &LZ4F_freeDecompressionContext);
  std::size_t in = 0, out = 0;
  for (std::size_t hint = 1; hint != 0;) {
    std::size_t read = data.size() - in, written = size - out;
    hint = LZ4F_decompress(context.get(), to + out, &written, data.data() + in, &read, nullptr);
    if (LZ4F_isError(hint) != 0) throw std::runtime_error(std::string("lz4: ") + LZ4F_getErrorName(hint));
    in += read;
    out += written;
    if (hint != 0 && read == 0 && written == 0) throw std::runtime_error("lz4: does not end where it should");
  }
  return out;
}

std::size_t decompressBz2(std::vector<std::uint8_t> data, std::uint8_t* to, std::size_t size) {
  auto written = static_cast<unsigned int>(size);
  const int status =
      BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(to), &written, reinterpret_cast<char*>(data.data()),
                                 static_cast<unsigned int>(data.size()), 0, 0);
  if (status != BZ_OK) throw std::runtime_error("bz2: error " + std::to_string(status));
  return written;
}

}  // namespace

Buffer decompress(const std::string& compression, const std::vector<std::uint8_t>& data, std::uint32_t size) {
  if (compression != "lz4" && compression != "bz2")
    throw std::runtime_error("compression '" + compression + "', expected none, lz4 or bz2");
  const bool is_lz4 = compression == "lz4";
  if (size > kLargestChunk || (is_lz4 && size / kMostThatLz4Expands > data.size()))
    throw std::runtime_error("claims to hold " + std::to_string(size) + " bytes");
  Buffer out{std::unique_ptr<std::uint8_t[]>(new std::uint8_t[size]), size};
  const std::size_t written =
      is_lz4 ? decompressLz4(data, out.data.get(), size) : decompressBz2(data, out.data.get(), size);
  if (written != size)
    throw std::runtime_error("holds " + std::to_string(written) + " bytes, expected " + std::to_string(size));
  return out;
}

}  // namespace rgbd_sfm_fusion::bag
