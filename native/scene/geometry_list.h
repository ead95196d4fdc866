// SPDX-License-Identifier: GPL-3.0-or-later
// The geometries of a frame.  They can be shared with another frame's that outlives, or precedes,
// this one; what is made of them knows them by address.
#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "scene/geometry_data.h"

namespace granita {

/// As a std::vector of GeometryData, but for share() and adopt(); a copy holds copies.
class GeometryList {
  public:
    GeometryList() = default;
    GeometryList(const GeometryList& other) {
        for (const auto& item : other.m_items)
            m_items.push_back(std::make_shared<GeometryData>(*item));
    }
    GeometryList(GeometryList&&) = default;
    GeometryList& operator=(GeometryList other) {
        m_items.swap(other.m_items);
        return *this;
    }
    ~GeometryList() = default;

    std::size_t size() const { return m_items.size(); }
    bool empty() const { return m_items.empty(); }
    void clear() { m_items.clear(); }
    GeometryData& operator[](std::size_t i) { return *m_items[i]; }
    const GeometryData& operator[](std::size_t i) const { return *m_items[i]; }
    GeometryData& at(std::size_t i) { return *m_items.at(i); }
    const GeometryData& at(std::size_t i) const { return *m_items.at(i); }
    GeometryData& back() { return *m_items.back(); }
    GeometryData& front() { return *m_items.front(); }
    void push_back(GeometryData data) {
        m_items.push_back(std::make_shared<GeometryData>(std::move(data)));
    }
    GeometryData& emplace_back() {
        push_back({});
        return back();
    }

    std::shared_ptr<const GeometryData> share(std::size_t i) const { return m_items[i]; }
    /// Puts one of another frame, equal in every byte, in the place of its own.
    void adopt(std::size_t i, const GeometryList& other, std::size_t j) {
        m_items[i] = other.m_items[j];
    }

    /// Who is in it.
    std::set<const GeometryData*> members() const {
        std::set<const GeometryData*> found;
        for (const auto& item : m_items) found.insert(item.get());
        return found;
    }

    /// Holds the same ones from now on.
    void share_all(const GeometryList& other) { m_items = other.m_items; }

    template <class List, class Item>
    struct Iterator {
        List* list;
        std::size_t i;
        Item& operator*() const { return (*list)[i]; }
        Iterator& operator++() { return ++i, *this; }
        bool operator==(const Iterator& other) const { return i == other.i; }
    };
    auto begin() { return Iterator<GeometryList, GeometryData>{this, 0}; }
    auto end() { return Iterator<GeometryList, GeometryData>{this, size()}; }
    auto begin() const { return Iterator<const GeometryList, const GeometryData>{this, 0}; }
    auto end() const { return Iterator<const GeometryList, const GeometryData>{this, size()}; }

  private:
    std::vector<std::shared_ptr<GeometryData>> m_items;
};

}  // namespace granita
