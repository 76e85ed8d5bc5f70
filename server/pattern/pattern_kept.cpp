#include "server/pattern/pattern_kept.h"

#include <span>
#include <type_traits>

namespace tessera {

namespace {

/// Fields one after the other, each at its full width or with its length before it.
class Key {
  public:
    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_pointer_v<T> Key& add(T value) {
        text_.append(reinterpret_cast<const char*>(&value), sizeof value);
        return *this;
    }
    template <class T>
    Key& add(std::span<const T> values) {
        add(values.size());
        for (const T& value : values) add(value);
        return *this;
    }
    Key& add(const std::string& text) {
        add(text.size());
        text_ += text;
        return *this;
    }
    Key& add(const Look& look) {
        return add(look.pattern).add(look.x).add(look.y).add(look.turn).add(look.scale);
    }
    std::string text() { return std::move(text_); }

  private:
    std::string text_;
};

}  // namespace

std::string key_of(const ReferencePlan& plan) {
    Key key;
    key.add(plan.grid.cell_log2).add(plan.grid.cell_slices).add(plan.patterns.get());
    key.add(plan.grid.quadtree ? plan.grid.quadtree->name() : std::string{});
    if (plan.transform)
        key.add(plan.transform->overflow)
            .add(std::span<const double>{plan.transform->turns})
            .add(std::span<const double>{plan.transform->scales});
    const bool typed = plan.program->basis() == CellProgram::Basis::typed;
    const std::uint32_t types = typed ? plan.grid.quadtree->types() : 1;
    key.add(types);
    for (std::uint32_t type = 0; type < types; ++type)
        key.add(plan.program->look_of_type(static_cast<std::uint16_t>(type)));
    return key.text();
}

std::string key_of(const JointPart& whole) {
    Key key;
    if (whole.reference != nullptr) key.add(key_of(*whole.reference));
    key.add(std::span<const float>{whole.color});
    if (whole.map != nullptr) {
        key.add(whole.map->width)
            .add(whole.map->cells_log2)
            .add(whole.map->least)
            .add(whole.map->most)
            .add(whole.map->values.size());
        whole.map->values.for_spans([&key](std::span<const std::int32_t> values) { key.add(values); });
    }
    for (const JointPart& part : whole.parts) key.add(key_of(part));
    return key.text();
}

std::shared_ptr<const PatternMips> PatternKept::mips(const std::shared_ptr<const PatternImages>& patterns) {
    const std::string key = Key{}.add(patterns.get()).text();
    {
        const std::lock_guard lock{mutex_};
        if (Entry<PatternMips>* found = find(mips_, key)) return found->is;
    }
    auto made = std::make_shared<const PatternMips>(*patterns);
    const std::lock_guard lock{mutex_};
    mips_[key] = {made, patterns, round_};
    return made;
}

std::shared_ptr<const InstanceImages> PatternKept::instances(const ReferencePlan& plan) {
    Key of;
    of.add(plan.patterns.get())
        .add(std::span<const double>{plan.transform->turns})
        .add(std::span<const double>{plan.transform->scales});
    for (const bool shown : InstanceImages::shown_looks(plan)) of.add(shown);
    const std::string key = of.text();
    {
        const std::lock_guard lock{mutex_};
        if (Entry<InstanceImages>* found = find(instances_, key)) return found->is;
    }
    auto made = std::make_shared<const InstanceImages>(plan);
    const std::lock_guard lock{mutex_};
    instances_[key] = {made, plan.patterns, round_};
    return made;
}

void PatternKept::next_round() {
    const std::lock_guard lock{mutex_};
    const auto unused = [&](const auto& entry) { return entry.second.round + 1 < round_; };
    std::erase_if(textures_, unused);
    std::erase_if(mips_, unused);
    std::erase_if(instances_, unused);
    ++round_;
}

}  // namespace tessera
