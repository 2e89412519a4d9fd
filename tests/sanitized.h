// Fewer rounds where each takes much longer.
#pragma once

namespace raio::tests {

// Sanitizers make brute force up to a hundred times as slow; what they look for shows in fewer
// rounds, too.
template <class T>
constexpr T if_sanitized(T fewer, T usual) {
#ifdef RAIO_SANITIZED
  constexpr bool kSanitized = true;
#else
  constexpr bool kSanitized = false;
#endif
  return kSanitized ? fewer : usual;
}

}  // namespace raio::tests
