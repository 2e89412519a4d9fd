// Fewer rounds where each takes much longer.
#pragma once

namespace raio::core::tests {

// Sanitizers slow brute force down up to a hundred times; fewer rounds reveal as much.
template <class T>
constexpr T if_sanitized(T fewer, T usual) {
#ifdef RAIO_SANITIZED
  constexpr bool kSanitized = true;
#else
  constexpr bool kSanitized = false;
#endif
  return kSanitized ? fewer : usual;
}

}  // namespace raio::core::tests
