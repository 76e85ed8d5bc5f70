// page_hashes [--threads N] [--check FILE | --update FILE]: evaluates the pages and footprints of the list,
// and prints their hashes, holds them to a file's, or writes the file. Exit code 0: equal; 1: not; 77: this
// processor does not run the instruction set that TESSERA_KERNELS asks for.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <thread>

#include "server/blocks/kernels.h"
#include "server/texture/kernels.h"
#include "tests/property/stability/filter_hash_list.h"
#include "tests/property/stability/page_hash_list.h"

namespace tessera::tests {
namespace {

constexpr int not_tried = 77;

using Job = std::function<std::string()>;

std::vector<Job> jobs_of(const std::vector<Subject>& subjects) {
    std::vector<Job> jobs;
    for (const HashedPage& page : hashed_pages(subjects))
        jobs.emplace_back([page] { return hash_line(page); });
    for (const HashedFilter& filter : hashed_filters(subjects))
        jobs.emplace_back([filter] { return hash_line(filter); });
    return jobs;
}

std::vector<std::string> lines_of(const std::vector<Job>& jobs, std::size_t threads) {
    std::vector<std::string> lines(jobs.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        // Several threads go from the end, so that none finds what it shares in the order in which one makes
        // it
        for (std::size_t i = next++; i < jobs.size(); i = next++) {
            const std::size_t job = threads == 1 ? i : jobs.size() - 1 - i;
            lines[job] = jobs[job]();
        }
    };
    std::vector<std::jthread> workers;
    for (std::size_t t = 1; t < threads; ++t) workers.emplace_back(work);
    work();
    workers.clear();
    return lines;
}

int check(const std::vector<std::string>& lines, const std::string& file) {
    std::ifstream in{file};
    std::vector<std::string> expected;
    for (std::string line; std::getline(in, line);) expected.push_back(line);
    std::size_t different = 0;
    for (std::size_t i = 0; i < std::max(lines.size(), expected.size()); ++i) {
        const std::string is = i < lines.size() ? lines[i] : "(no such page)",
                          was = i < expected.size() ? expected[i] : "(not in the list)";
        if (is == was || ++different > 10) continue;
        std::cout << "  is  " << is << "\n  was " << was << '\n';
    }
    std::cout << lines.size() - std::min(lines.size(), different) << " of " << expected.size()
              << " lines reproduced\n";
    return different == 0 && !expected.empty() ? 0 : 1;
}

int run(const std::vector<std::string>& arguments) {
    std::size_t threads = 1;
    std::string to_check, to_update;
    for (std::size_t i = 0; i < arguments.size(); i += 2) {
        if (i + 1 == arguments.size()) throw std::invalid_argument{arguments[i] + " needs a value"};
        const std::string &option = arguments[i], &value = arguments[i + 1];
        if (option == "--threads")
            threads = std::stoul(value);
        else if (option == "--check")
            to_check = value;
        else if (option == "--update")
            to_update = value;
        else
            throw std::invalid_argument{"unknown option " + option};
    }
    if (const char* asked = std::getenv("TESSERA_KERNELS");
        asked != nullptr && block_kernels_of(asked) == nullptr) {
        std::cout << "NOT TRIED: this processor does not run " << asked << '\n';
        return not_tried;
    }
    const std::vector<Subject> all = subjects();
    const std::vector<std::string> lines = lines_of(jobs_of(all), threads);
    if (!to_check.empty()) {
        std::cout << "kernels " << kernels().name << ", threads " << threads << ": " << std::flush;
        return check(lines, to_check);
    }
    std::ofstream file;
    if (!to_update.empty()) file.open(to_update, std::ios::trunc);
    std::ostream& out = to_update.empty() ? std::cout : file;
    for (const std::string& line : lines) out << line << '\n';
    return out.flush() ? 0 : 1;
}

}  // namespace
}  // namespace tessera::tests

int main(int count, char** words) {
    try {
        return tessera::tests::run({words + 1, words + count});
    } catch (const std::exception& problem) {
        std::cerr << "page_hashes: " << problem.what() << '\n';
        return 2;
    }
}
