#include "server/sampling/sample_answer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "proto/sample.pb.h"

namespace tessera {
namespace {

float at_least(double value) {
    const auto nearest = static_cast<float>(value);
    return static_cast<double>(nearest) < value ? std::nextafter(nearest, std::numeric_limits<float>::max())
                                                : nearest;
}

float at_most(double value) {
    const auto nearest = static_cast<float>(value);
    return static_cast<double>(nearest) > value
               ? std::nextafter(nearest, std::numeric_limits<float>::lowest())
               : nearest;
}

template <class Number>
void add_number(std::string& text, Number value) {
    char digits[40];
    const auto [end, failure] = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, failure == std::errc{} ? end : digits);
}

/// "name": [ … ] with so many numbers a line.
template <class Numbers>
void add_list(std::string& text, const char* name, const Numbers& numbers, int a_line) {
    text.append(",\n  \"").append(name).append("\": [");
    for (int i = 0; i < numbers.size(); ++i) {
        text += i == 0 ? "\n    " : i % a_line == 0 ? ",\n    " : ", ";
        add_number(text, numbers[i]);
    }
    text += "\n  ]";
}

std::string to_json(const proto::SampleAnswer& answer) {
    std::string text;
    text.reserve(256 + static_cast<std::size_t>(answer.texels_size()) * 96);
    text += "{\n  \"filters\": [";
    for (int i = 0; i < answer.filters_size(); ++i)  // names are of letters, digits and hyphens
        text.append(i == 0 ? "\"" : ", \"").append(answer.filters(i)).append(1, '"');
    text += "],\n  \"revision\": \"";
    add_number(text, answer.revision());
    text += "\",\n  \"milliseconds\": ";
    add_number(text, answer.milliseconds());
    add_list(text, "colors", answer.colors(), 4);
    add_list(text, "bound_codes", answer.bound_codes(), 8);
    add_list(text, "confidence", answer.confidence(), 8);
    add_list(text, "texels", answer.texels(), 8);
    add_list(text, "filter", answer.filter(), 32);
    text += "\n}\n";
    return text;
}

}  // namespace

std::string write_sample_answer(const SamplePlan& plan, std::span<const FilteredSample> samples,
                                std::span<const std::uint8_t> steps_taken, std::uint64_t revision,
                                std::chrono::nanoseconds time, WireCoding coding) {
    proto::SampleAnswer answer;
    const auto count = static_cast<int>(samples.size());
    answer.mutable_colors()->Reserve(4 * count);
    answer.mutable_bound_codes()->Reserve(count);
    answer.mutable_confidence()->Reserve(count);
    answer.mutable_texels()->Reserve(count);
    answer.mutable_filter()->Reserve(count);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        for (const float channel : samples[i].color) answer.add_colors(channel);
        answer.add_bound_codes(at_least(samples[i].bound_codes));
        answer.add_confidence(at_most(samples[i].confidence));
        answer.add_texels(static_cast<std::uint32_t>(
            std::min<std::uint64_t>(samples[i].texels, std::numeric_limits<std::uint32_t>::max())));
        answer.add_filter(steps_taken[i]);
    }

    // Only the filters that were used, each once, in the plan's order
    std::vector<std::uint32_t> place(plan.steps.size(), 0);
    for (std::size_t step = 0; step < plan.steps.size(); ++step) {
        if (std::find(steps_taken.begin(), steps_taken.end(), step) == steps_taken.end()) continue;
        const std::string name = name_of(plan.steps[step].filter);
        const auto known = std::find(answer.filters().begin(), answer.filters().end(), name);
        place[step] = static_cast<std::uint32_t>(known - answer.filters().begin());
        if (known == answer.filters().end()) answer.add_filters(name);
    }
    for (std::uint32_t& filter : *answer.mutable_filter()) filter = place[filter];

    answer.set_revision(revision);
    answer.set_milliseconds(std::chrono::duration<double, std::milli>(time).count());
    return coding == WireCoding::json ? to_json(answer) : answer.SerializeAsString();
}

}  // namespace tessera
