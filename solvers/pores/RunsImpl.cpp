// Compiled once for each instruction set, with LAMELLA_RUN_KERNELS as the name of the table. Built-in functions and
// plain loops only: an inline function of a library, compiled for a newer processor, could be linked into other code.
#include "pores/Runs.h"

#include <cstddef>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace lamella::pores
{

extern const RunKernels LAMELLA_RUN_KERNELS;

namespace
{

using Word = std::uint64_t;

#if defined(__AVX2__)

Word equal64(const std::uint8_t* bytes, std::uint8_t wanted)
{
  const __m256i value = _mm256_set1_epi8(static_cast<char>(wanted));
  const auto half = [&](const std::uint8_t* at)
  {
    const __m256i loaded = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at));
    return static_cast<Word>(static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(loaded, value))));
  };
  return half(bytes) | half(bytes + 32) << 32;
}

#elif defined(__SSE2__)

Word equal64(const std::uint8_t* bytes, std::uint8_t wanted)
{
  const __m128i value = _mm_set1_epi8(static_cast<char>(wanted));
  Word word = 0;
  for (int part = 0; part < 4; ++part)
  {
    const __m128i loaded = _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes + 16 * part));
    word |= static_cast<Word>(static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(loaded, value))))
      << (16 * part);
  }
  return word;
}

#else

Word equal64(const std::uint8_t* bytes, std::uint8_t wanted)
{
  Word word = 0;
  for (int i = 0; i < 64; ++i)
    word |= static_cast<Word>(bytes[i] == wanted ? 1 : 0) << i;
  return word;
}

#endif

Word equalSome(const std::uint8_t* bytes, std::int64_t count, std::uint8_t wanted)
{
  Word word = 0;
  for (std::int64_t i = 0; i < count; ++i)
    word |= static_cast<Word>(bytes[i] == wanted ? 1 : 0) << i;
  return word;
}

std::uint32_t scan(const std::uint8_t* phase, std::int64_t nodes, std::int64_t readable, std::uint8_t wanted,
  Word* bits, std::uint32_t* before, std::uint32_t runs)
{
  Word last = 0; // the bit before this word
  const std::int64_t whole = nodes / 64;
  const auto take = [&](std::int64_t w, Word word)
  {
    bits[w] = word;
    before[w] = runs;
    runs += static_cast<std::uint32_t>(__builtin_popcountll(word & ~(word << 1 | last)));
    last = word >> 63;
  };
  for (std::int64_t w = 0; w < whole; ++w)
    take(w, equal64(phase + 64 * w, wanted));
  const std::int64_t rest = nodes % 64;
  if (rest != 0)
    take(whole,
      64 * whole + 64 <= readable ? equal64(phase + 64 * whole, wanted) & ((static_cast<Word>(1) << rest) - 1)
                                  : equalSome(phase + 64 * whole, rest, wanted));
  return runs;
}

// Where runs of both rows overlap, the first node of the overlap stands for the pair: no other overlap is of the same
// two. Diagonally they touch besides where one begins right behind the other's end. In both cases the last run that
// begins in each row up to that node is the one.
template <bool Diagonal, typename Action>
inline __attribute__((always_inline)) void forContacts(Row a, Row b, std::int64_t words, const Action& action)
{
  Word lastA = 0;
  Word lastB = 0;
  Word lastBoth = 0;
  for (std::int64_t w = 0; w < words; ++w)
  {
    const Word bitsA = a.bits[w];
    const Word bitsB = b.bits[w];
    const Word shiftedA = bitsA << 1 | lastA;
    const Word shiftedB = bitsB << 1 | lastB;
    const Word beginA = bitsA & ~shiftedA;
    const Word beginB = bitsB & ~shiftedB;
    const Word both = bitsA & bitsB;
    Word places = both & ~(both << 1 | lastBoth);
    if constexpr (Diagonal)
      places |= (beginA & shiftedB & ~bitsB) | (beginB & shiftedA & ~bitsA);
    lastA = bitsA >> 63;
    lastB = bitsB >> 63;
    lastBoth = both >> 63;
    const std::uint32_t countA = a.before[w] - 1;
    const std::uint32_t countB = b.before[w] - 1;
    for (; places != 0; places &= places - 1)
    {
      const int beyond = 63 - __builtin_ctzll(places);
      action(countA + static_cast<std::uint32_t>(__builtin_popcountll(beginA << beyond)),
        countB + static_cast<std::uint32_t>(__builtin_popcountll(beginB << beyond)));
    }
  }
}

void unite(Row a, Row b, std::int64_t words, bool diagonal, std::uint32_t* parent)
{
  // Rem's way (Dijkstra, A Discipline of Programming, 1976, chapter 23): up both branches at once, where the parent is
  // the higher one, and every run on the way is handed to the lower parent. Most pairs are of one set already and have
  // one parent.
  const auto join = [parent](std::uint32_t runA, std::uint32_t runB)
  {
    std::uint32_t above = parent[runA];
    std::uint32_t below = parent[runB];
    while (above != below)
    {
      if (above < below)
      {
        const std::uint32_t other = above;
        above = below;
        below = other;
        const std::uint32_t run = runA;
        runA = runB;
        runB = run;
      }
      parent[runA] = below;
      if (runA == above) // a root
        return;
      runA = above;
      above = parent[runA];
    }
  };
  if (diagonal)
    forContacts<true>(a, b, words, join);
  else
    forContacts<false>(a, b, words, join);
}

std::int64_t contacts(Row a, Row b, std::int64_t words, bool diagonal, Contact* out)
{
  std::int64_t count = 0;
  const auto keep = [&](std::uint32_t runA, std::uint32_t runB) { out[count++] = { runA, runB }; };
  if (diagonal)
    forContacts<true>(a, b, words, keep);
  else
    forContacts<false>(a, b, words, keep);
  return count;
}

/// base + each of eight bytes.
inline __attribute__((always_inline)) void widen(const std::uint8_t* bytes, std::int32_t base, std::int32_t* out)
{
#if defined(__AVX2__)
  const __m256i wide = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_add_epi32(wide, _mm256_set1_epi32(base)));
#else
  for (int k = 0; k < 8; ++k)
    out[k] = base + bytes[k];
#endif
}

/// Places of the set bits of a byte.
struct BitPlaces
{
  std::uint8_t of[256][8] = {};
  constexpr BitPlaces()
  {
    for (int byte = 0; byte < 256; ++byte)
      for (int bit = 0, found = 0; bit < 8; ++bit)
        if ((byte >> bit & 1) != 0)
          of[byte][found++] = static_cast<std::uint8_t>(bit);
  }
};
constexpr BitPlaces bitPlaces;

std::int64_t edges(const Word* bits, std::int64_t nodes, std::int32_t* out)
{
  Word last = 0;
  std::int64_t count = 0;
  for (std::int64_t w = 0; 64 * w < nodes; ++w)
  {
    Word turns = bits[w] ^ (bits[w] << 1 | last);
    last = bits[w] >> 63;
    const auto base = static_cast<std::int32_t>(64 * w);
    const int found = __builtin_popcountll(turns);
    // eight at a time, needed or not: the processor then seldom guesses wrong how many there are
    if (found <= 8)
    {
      if (found != 0)
        for (int k = 0; k < 8; ++k)
        {
          out[count + k] = base + (turns != 0 ? __builtin_ctzll(turns) : 64);
          turns &= turns - 1;
        }
      count += found;
      continue;
    }
    for (int part = 0; part < 64; part += 8)
    {
      const auto byte = static_cast<std::uint8_t>(turns >> part);
      widen(bitPlaces.of[byte], base + part, out + count);
      count += __builtin_popcount(byte);
    }
  }
  if (count % 2 != 0)
    out[count++] = static_cast<std::int32_t>(nodes);
  return count / 2;
}

#if defined(__AVX2__)

// Whether a run begins a piece cannot be guessed: no branch. A piece is two vectors: four sums; then the box and the
// first node. Before every run the next piece is made ready, to begin there if it does: what is read, added to and
// written again is then the same for all, and short.
std::uint32_t measure(const std::int32_t* edges, std::int64_t runs, const std::uint32_t* piece, std::uint32_t known,
  std::int64_t index, std::int32_t y, std::int32_t z, Piece* pieces, std::uint32_t* sizes)
{
  static_assert(offsetof(Piece, low) == 32 && offsetof(Piece, high) == 44 && offsetof(Piece, first) == 56);
  constexpr std::int32_t least = -2147483647 - 1;
  constexpr std::int32_t most = 2147483647;
  const __m256i factors = _mm256_setr_epi64x(1, 0, y, z); // a node's part in size, 2x, y, z
  const __m256i place = _mm256_setr_epi32(0, y, z, 0, y, z, least, least);
  const __m256i nowhere = _mm256_setr_epi32(most, most, most, least, least, least, 0, 0);
  for (std::int64_t run = 0; run < runs; ++run)
  {
    const std::uint32_t number = piece[run];
    const std::int32_t begin = edges[2 * run];
    const std::int32_t last = edges[2 * run + 1] - 1;
    const auto length = static_cast<std::uint32_t>(last - begin + 1);
    const auto twiceX = static_cast<std::uint32_t>(begin) + static_cast<std::uint32_t>(last); // of a node, on average

    __m256i* const next = reinterpret_cast<__m256i*>(pieces + known);
    _mm256_store_si256(next, _mm256_setzero_si256());
    _mm256_store_si256(next + 1, _mm256_blend_epi32(nowhere, _mm256_set1_epi64x(index + begin), 0b11000000));
    sizes[known] = 0;
    known += number == known ? 1 : 0;

    sizes[number] += length;
    __m256i* const at = reinterpret_cast<__m256i*>(pieces + number);
    const __m256i sums =
      _mm256_mul_epu32(_mm256_blend_epi32(factors, _mm256_set1_epi32(static_cast<std::int32_t>(twiceX)), 0b00000100),
        _mm256_set1_epi32(static_cast<std::int32_t>(length)));
    _mm256_store_si256(at, _mm256_add_epi64(sums, _mm256_load_si256(at)));
    const __m256i box = _mm256_blend_epi32(
      _mm256_blend_epi32(place, _mm256_set1_epi32(begin), 0b00000001), _mm256_set1_epi32(last), 0b00001000);
    const __m256i before = _mm256_load_si256(at + 1);
    _mm256_store_si256(
      at + 1, _mm256_blend_epi32(_mm256_max_epi32(box, before), _mm256_min_epi32(box, before), 0b00000111));
  }
  return known;
}

#else

std::uint32_t measure(const std::int32_t* edges, std::int64_t runs, const std::uint32_t* piece, std::uint32_t known,
  std::int64_t index, std::int32_t y, std::int32_t z, Piece* pieces, std::uint32_t* sizes)
{
  for (std::int64_t run = 0; run < runs; ++run)
  {
    Piece& p = pieces[piece[run]];
    const std::int32_t begin = edges[2 * run];
    const std::int32_t last = edges[2 * run + 1] - 1;
    const std::int64_t length = last - begin + 1;
    const std::int64_t twiceX = (static_cast<std::int64_t>(begin) + last) * length;
    if (piece[run] == known)
    {
      ++known;
      sizes[piece[run]] = static_cast<std::uint32_t>(length);
      // member by member: one put together elsewhere and copied as a whole has to wait for its parts
      p.first = index + begin;
      p.size = length;
      p.twiceX = twiceX;
      p.sumY = y * length;
      p.sumZ = z * length;
      p.low[0] = begin;
      p.low[1] = y;
      p.low[2] = z;
      p.high[0] = last;
      p.high[1] = y;
      p.high[2] = z;
      continue;
    }
    sizes[piece[run]] += static_cast<std::uint32_t>(length);
    p.size += length;
    p.twiceX += twiceX;
    p.sumY += y * length;
    p.sumZ += z * length;
    p.low[0] = begin < p.low[0] ? begin : p.low[0];
    p.high[0] = last > p.high[0] ? last : p.high[0];
    // rows come in the order of memory: z never falls, but y does in the next layer
    p.low[1] = y < p.low[1] ? y : p.low[1];
    p.high[1] = y > p.high[1] ? y : p.high[1];
    p.high[2] = z;
  }
  return known;
}

#endif

constexpr std::int64_t stride = 8;

/// Eight values of four bytes: the first `left` of them `inside`, the others `background`.
template <typename Value>
inline __attribute__((always_inline)) void writeEight(Value* out, std::int32_t left, Value inside, Value background)
{
#if defined(__AVX2__)
  static_assert(sizeof(Value) == 4);
  const __m256i within = _mm256_cmpgt_epi32(_mm256_set1_epi32(left), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  const __m256i values = _mm256_blendv_epi8(_mm256_set1_epi32(__builtin_bit_cast(std::int32_t, background)),
    _mm256_set1_epi32(__builtin_bit_cast(std::int32_t, inside)), within);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), values);
#else
  for (std::int32_t k = 0; k < 8; ++k)
    out[k] = k < left ? inside : background;
#endif
}

template <typename Value>
void fill(const std::int32_t* edges, std::int64_t runs, const std::uint32_t* piece, const Value* value,
  Value background, Value* out, std::int64_t nodes, std::int64_t room)
{
  for (std::int64_t x = 0; x < nodes; ++x)
    out[x] = background;
  for (std::int64_t run = 0; run < runs; ++run)
  {
    const std::int64_t end = edges[2 * run + 1];
    const Value inside = value[piece[run]];
    std::int64_t x = edges[2 * run];
    // Whole vectors, whatever the run's length: what follows it in the last one is background anyway, or is written
    // after it.
    for (; x + stride <= room; x += stride)
    {
      const auto left = static_cast<std::int32_t>(end - x);
      writeEight(out + x, left, inside, background);
      if (left <= stride)
        break;
    }
    if (x + stride > room)
      for (; x < end; ++x)
        out[x] = inside;
  }
}

} // namespace

const RunKernels LAMELLA_RUN_KERNELS{ scan, unite, contacts, edges, measure, fill<std::int32_t>, fill<float> };

} // namespace lamella::pores
