// Fuzz target for tuned files, which `raya render` reads and `raya tune` extends: a file must be either used, or
// ignored with a warning.
#include "host/error.hpp"
#include "host/tune/store.hpp"
#include "host/version.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace raya;
using namespace raya::fuzz;

const DeviceInfo kDevice = {.name = "device",
                            .platform = "platform",
                            .version = "version",
                            .driver = "driver",
                            .type = "cpu",
                            .compute_units = 2,
                            .local_memory_bytes = 1 << 16,
                            .global_memory_bytes = 1u << 30,
                            .max_allocation_bytes = 1u << 28,
                            .max_group_size = 4096};

/// Replaces the placeholder @version@ of the corpus's files with raya's version.
std::string with_version(std::string text) {
    constexpr std::string_view kPlaceholder = "@version@";
    if (const std::size_t at = text.find(kPlaceholder); at != std::string::npos)
        text.replace(at, kPlaceholder.size(), raya_version());
    return text;
}

void check_choices(const std::string& file) {
    int warnings = 0;
    const TunedSource source = stored_choices([&](const std::string& warning) {
        check_refusal(warning, file);
        ++warnings;
    });
    for (const bool torus : {false, true})
        for (const std::uint32_t accel : {0u, 1u, 2u}) {
            const auto choice = source(kDevice, {.torus = torus, .accel = accel, .fp32 = true});
            if (choice && warnings > 0) report_finding("a tuned file is used despite a warning", choice->origin);
        }
    if (warnings > 1) report_finding("the reader warns more than once", file);
}

/// Checks device names, folders and environment variables with unusual values.
void check_environment(const ScratchFolder& folder) {
    DeviceInfo device = kDevice;
    device.name = "--a  b/c(R)-- 1.0+x";
    if (tuned_file_name(device).find_first_of("/ ()") != std::string::npos)
        report_finding("the name of a tuned file has forbidden characters", tuned_file_name(device));
    const auto is_refused = [](auto call) {
        try {
            call();
        } catch (const UserError& error) {
            return !std::string_view(error.what()).empty();
        }
        return false;
    };
    ::setenv("RAYA_TUNED", "maybe", 1);
    if (!is_refused([] { stored_choices({}); })) report_finding("an invalid variable is accepted", "RAYA_TUNED=maybe");
    ::setenv("RAYA_TUNED", "off", 1);
    if (stored_choices({})) report_finding("tuned files are used", "RAYA_TUNED=off");
    ::unsetenv("RAYA_TUNED");
    ::setenv("XDG_CACHE_HOME", "no/absolute/path", 1);
    ::setenv("HOME", folder.path("").c_str(), 1);
    if (is_refused([] { tuned_path(kDevice); })) report_finding("a valid folder is refused", "HOME");
    if (const TunedSource source = stored_choices({}); source && source(kDevice, {}))
        report_finding("a missing tuned file is used", folder.path(""));
    ::unsetenv("HOME");
    if (!is_refused([] { tuned_path(kDevice); }) || stored_choices({}))
        report_finding("a missing HOME is accepted", "HOME, XDG_CACHE_HOME");
    ::setenv("XDG_CACHE_HOME", "/dev/null", 1);
    if (!is_refused([] { tuned_path(kDevice); }))
        report_finding("a path that is not a folder is accepted", "XDG_CACHE_HOME=/dev/null");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const ScratchFolder folder;
    static const bool environment_checked = (check_environment(folder), true);
    if (!environment_checked) return 0;
    ::setenv("XDG_CACHE_HOME", folder.path("").c_str(), 1);
    static const std::string file = tuned_path(kDevice).string();
    const std::string text = with_version(std::string(text_of(data, size)));
    folder.write("raya/" + tuned_file_name(kDevice), text);
    check_choices(file);
    try {
        const Json written = to_json(read_tuned(text, "tuned.json", kDevice));
        if (to_json(read_tuned(json_dump(written), "tuned.json", kDevice)) != written)
            report_finding("a tuned file changes if it is written and read again", json_dump(written));
        save_tuned(kDevice, {.key = {}, .values = {}, .scene = "s"});
    } catch (const UserError& error) {
        if (std::string_view(error.what()).empty()) report_finding("an error message without a reason", text);
    }
    return 0;
}
