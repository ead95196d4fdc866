// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pthread.h>

#include <cstddef>

namespace granita {

/// While it lives no thread can be made, as where a container's limit of processes is reached:
/// stacks are to be larger than any machine's memory.
class NoNewThreads {
  public:
    NoNewThreads() {
        pthread_attr_init(&m_attributes);
        pthread_getattr_default_np(&m_attributes);
        pthread_attr_getstacksize(&m_attributes, &m_before);
        pthread_attr_setstacksize(&m_attributes, std::size_t{1} << 46);
        pthread_setattr_default_np(&m_attributes);
    }
    ~NoNewThreads() {
        pthread_attr_setstacksize(&m_attributes, m_before);
        pthread_setattr_default_np(&m_attributes);
        pthread_attr_destroy(&m_attributes);
    }
    NoNewThreads(const NoNewThreads&) = delete;
    NoNewThreads& operator=(const NoNewThreads&) = delete;

  private:
    pthread_attr_t m_attributes;
    std::size_t m_before = 0;
};

}  // namespace granita
