#include "io/Provenance.h"

#include "core/Error.h"

#include <openssl/evp.h>

#include <array>

namespace lamella::io
{

namespace
{

/// Looked for once: that takes longer than a short text.
const EVP_MD* sha256()
{
  static const EVP_MD* const found = EVP_MD_fetch(nullptr, "SHA256", nullptr);
  return found;
}

EVP_MD_CTX* contextOf(void* context)
{
  return static_cast<EVP_MD_CTX*>(context);
}

void require(bool done)
{
  if (!done)
    throw Error("SHA-256 is not to be had from libcrypto", "look at its settings (openssl.cnf), or at the memory");
}

} // namespace

Sha256::Sha256()
  : context_(EVP_MD_CTX_new())
{
  const bool begun =
    context_ != nullptr && sha256() != nullptr && EVP_DigestInit_ex2(contextOf(context_), sha256(), nullptr) == 1;
  if (!begun)
    EVP_MD_CTX_free(contextOf(context_));
  require(begun);
}

Sha256::~Sha256()
{
  EVP_MD_CTX_free(contextOf(context_));
}

void Sha256::update(std::span<const std::byte> bytes)
{
  require(EVP_DigestUpdate(contextOf(context_), bytes.data(), bytes.size()) == 1);
}

std::string Sha256::finish()
{
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  unsigned size = 0;
  require(EVP_DigestFinal_ex(contextOf(context_), hash.data(), &size) == 1);
  std::string text;
  for (unsigned i = 0; i < size; ++i)
  {
    text += "0123456789abcdef"[hash[i] >> 4U];
    text += "0123456789abcdef"[hash[i] & 15U];
  }
  return text;
}

} // namespace lamella::io
