#include "worker_loop/check_job.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "queue/redis_server.h"

namespace nocturne {
namespace {

TEST(CheckJob, AcceptsTheBounds) {
  v1::Job job = test::make_job();
  EXPECT_NO_THROW(check_job(job));
  job.set_film_width(16384);
  job.set_film_height(4096);
  job.mutable_tile()->set_x(16384 - 1024);
  job.mutable_tile()->set_width(1024);
  job.set_first_sample((1U << 31) - 1);
  job.set_end_sample(1U << 31);
  EXPECT_NO_THROW(check_job(job));
}

// A range of forward photons, of the largest film.
v1::Job photons() {
  v1::Job job = test::make_job();
  job.set_film_width(4096);
  job.set_film_height(4096);
  job.mutable_tile()->set_x(0);
  job.mutable_tile()->set_y(0);
  job.mutable_tile()->set_width(4096);
  job.mutable_tile()->set_height(4096);
  job.set_photons_by_tiles_of(32);
  return job;
}

TEST(CheckJob, AcceptsForwardPhotonsOfAWholeFilm) { EXPECT_NO_THROW(check_job(photons())); }

struct BadJob {
  std::string field;
  std::function<void(v1::Job&)> spoil;
};

class CheckJobRefuses : public testing::TestWithParam<BadJob> {};

TEST_P(CheckJobRefuses, AndNamesTheField) {
  v1::Job job = test::make_job();
  GetParam().spoil(job);
  try {
    check_job(job);
    FAIL() << "accepted";
  } catch (const JobError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("job." + GetParam().field)) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fields, CheckJobRefuses,
    testing::Values(
        BadJob{"scene ", [](v1::Job& job) { job.set_scene("short"); }},
        BadJob{"film_width ", [](v1::Job& job) { job.set_film_width(0); }},
        BadJob{"film_width ", [](v1::Job& job) { job.set_film_width(16385); }},
        BadJob{"film_height ", [](v1::Job& job) { job.set_film_height(16385); }},
        BadJob{"film_width x film_height ",
               [](v1::Job& job) {
                 job.set_film_width(16384);
                 job.set_film_height(16384);
               }},
        BadJob{"tile.width ", [](v1::Job& job) { job.clear_tile(); }},
        BadJob{"tile.height ", [](v1::Job& job) { job.mutable_tile()->set_height(1025); }},
        BadJob{"tile.x + width ", [](v1::Job& job) { job.mutable_tile()->set_x(63); }},
        BadJob{"tile.x + width ", [](v1::Job& job) { job.mutable_tile()->set_x(0xffffffffU); }},
        BadJob{"tile.y + height ", [](v1::Job& job) { job.mutable_tile()->set_y(31); }},
        BadJob{"end_sample ", [](v1::Job& job) { job.set_end_sample(0); }},
        BadJob{"end_sample ", [](v1::Job& job) { job.set_end_sample((1U << 31) + 1); }},
        BadJob{"first_sample ", [](v1::Job& job) { job.set_first_sample(4); }},
        BadJob{"tile.width ",
               [](v1::Job& job) {
                 job = photons();
                 job.mutable_tile()->set_width(1024);
               }},
        BadJob{"film_width x film_height ",
               [](v1::Job& job) {
                 job = photons();
                 job.set_film_width(4097);
                 job.mutable_tile()->set_width(4097);
               }},
        BadJob{"photons_by_tiles_of ",
               [](v1::Job& job) {
                 job = photons();
                 job.set_photons_by_tiles_of(1025);
               }},
        BadJob{"photons_by_tiles_of % 4 ", [](v1::Job& job) {
                 job = photons();
                 job.set_photons_by_tiles_of(30);
               }}));

}  // namespace
}  // namespace nocturne
