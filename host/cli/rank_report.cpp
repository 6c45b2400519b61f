#include "host/cli/rank_report.hpp"

#include "host/report/profile_table.hpp"

namespace raya {

std::vector<Json> rank_reports(Ranks& ranks, const Session& session, const char* parts_member, const RankWork& work) {
    if (!ranks.has_several()) return {};
    const DeviceInfo& device = session.device();
    const Json this_rank = {{"rank", ranks.rank()},
                            {"host", ranks.host()},
                            {parts_member, work.parts},
                            {"device",
                             {{"name", device.name},
                              {"platform", device.platform},
                              {"version", device.version},
                              {"compute_units", device.compute_units},
                              {"lanes", work.lanes},
                              {"group_size", work.group_size},
                              {"bytes_taken", session.bytes_taken()}}},
                            {"build_s", work.build_s},
                            {"render_s", work.render_s},
                            {"messages_sent", work.traffic.messages},
                            {"bytes_sent", work.traffic.bytes},
                            {"waiting_s", work.traffic.waiting_s},
                            {"commands", commands_json(work.commands, true)}};
    std::vector<Json> reports;
    for (const std::string& text : ranks.gather(this_rank.dump()))
        reports.push_back(Json::parse(text, {"the report of a rank"}));
    return reports;
}

}  // namespace raya
