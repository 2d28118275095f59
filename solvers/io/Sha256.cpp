// SHA-256 after FIPS 180-4, section 6.2. None of the libraries that we link below VTK has it.
#include "io/Provenance.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <type_traits>
#include <utility>

namespace lamella::io
{

namespace
{

// The first 32 bits of the fractional parts of the cube roots of the first 64 primes (section 4.2.2).
constexpr std::uint32_t roundConstants[64] = { 0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1,
  0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7,
  0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
  0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967, 0x27b70a85,
  0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85, 0xa2bfe8a1, 0xa81a664b,
  0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116, 0x1e376c08, 0x2748774c,
  0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208,
  0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2 };

} // namespace

Sha256::Sha256()
  : state_{ 0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19 }
  , buffer_{}
{
}

void Sha256::block(const std::byte* data)
{
  std::uint32_t w[64];
  for (int t = 0; t < 16; ++t)
  {
    w[t] = 0;
    for (int byte = 0; byte < 4; ++byte)
    {
      w[t] = (w[t] << 8) | std::to_integer<std::uint32_t>(data[4 * t + byte]);
    }
  }
  for (int t = 16; t < 64; ++t)
  {
    const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ (w[t - 15] >> 3);
    const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ (w[t - 2] >> 10);
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  std::uint32_t v[8];
  std::copy(std::begin(state_), std::end(state_), v);
  // The standard moves a to b, b to c … after each round; here the names move: what is a in round t is h in the next.
  const auto round = [&](int t, auto shift)
  {
    constexpr unsigned s = decltype(shift)::value;
    const auto at = [&](unsigned name) -> std::uint32_t& { return v[(name - s) % 8]; };
    const std::uint32_t s1 = std::rotr(at(4), 6) ^ std::rotr(at(4), 11) ^ std::rotr(at(4), 25);
    const std::uint32_t choose = (at(4) & at(5)) ^ (~at(4) & at(6));
    const std::uint32_t t1 = at(7) + s1 + choose + roundConstants[t + static_cast<int>(s)] + w[t + static_cast<int>(s)];
    const std::uint32_t s0 = std::rotr(at(0), 2) ^ std::rotr(at(0), 13) ^ std::rotr(at(0), 22);
    const std::uint32_t majority = (at(0) & at(1)) ^ (at(0) & at(2)) ^ (at(1) & at(2));
    at(3) += t1;
    at(7) = t1 + s0 + majority;
  };
  for (int t = 0; t < 64; t += 8)
  {
    [&]<unsigned... s>(std::integer_sequence<unsigned, s...>)
    {
      (round(t, std::integral_constant<unsigned, s>()), ...);
    }
    (std::make_integer_sequence<unsigned, 8>());
  }
  for (int i = 0; i < 8; ++i)
  {
    state_[i] += v[i];
  }
}

void Sha256::update(std::span<const std::byte> bytes)
{
  total_ += bytes.size();
  while (!bytes.empty())
  {
    if (filled_ == 0 && bytes.size() >= 64)
    {
      block(bytes.data());
      bytes = bytes.subspan(64);
      continue;
    }
    const std::size_t take = std::min(bytes.size(), 64 - filled_);
    std::memcpy(buffer_ + filled_, bytes.data(), take);
    filled_ += take;
    bytes = bytes.subspan(take);
    if (filled_ == 64)
    {
      block(buffer_);
      filled_ = 0;
    }
  }
}

std::string Sha256::finish()
{
  const std::uint64_t bits = total_ * 8;
  std::byte tail[128] = { std::byte{ 0x80 } };
  const std::size_t zeros = (filled_ < 56 ? 56 : 120) - filled_;
  for (std::size_t byte = 0; byte < 8; ++byte)
  {
    tail[zeros + byte] = static_cast<std::byte>(bits >> (56 - 8 * byte));
  }
  update({ tail, zeros + 8 });

  std::string text;
  text.reserve(64);
  for (const std::uint32_t word : state_)
  {
    for (int shift = 28; shift >= 0; shift -= 4)
    {
      text += "0123456789abcdef"[(word >> shift) & 15];
    }
  }
  return text;
}

} // namespace lamella::io
